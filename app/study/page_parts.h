// Building blocks of the page of a study: safe text, tables, sections and the words that several sections
// use.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "app/study/study_summary.h"
#include "engine/base/result.h"
#include "engine/exchange/json.h"

namespace spoonbill {

// Returns the text with the characters that mean something in HTML replaced.
std::string html(std::string_view text);
std::string base64(std::string_view bytes);

const char* name_of(Verdict verdict);
std::string degrees(double angle_deg);                   // "12.5°"
std::string range_text(const Range<double>& range_deg);  // "-20° to 5°"
// Returns what a series tries but for its spoon: "gelatin, friction 0.1, helping 0.8".
std::string series_label(const StudySeries& series);

// Returns the beginning of a section, which the caller ends with "</section>".
std::string section(const char* id, const char* heading);
// Returns a script element of this id with data for the page's script.
std::string data_element(const char* id, const Json& data);

// Returns a page that needs no other file and no network: `body` is its HTML, without the heading. Its style
// and its script come with the program; the error names a file that is missing.
Result<std::string> make_page(const std::string& title, const std::string& heading, const std::string& body);

// An HTML table that grows row by row. A heading is aligned as the cells of the first row are.
class PageTable {
 public:
  PageTable(std::string_view id, std::vector<std::string> headings);

  PageTable& row();
  PageTable& text(std::string_view value);
  PageTable& long_text(std::string_view value);
  // Shows `shown`, and sorts by `value`.
  PageTable& number(double value, const std::string& shown);
  PageTable& number(double value, int decimals);
  PageTable& verdict(Verdict verdict);

  std::string finish();

 private:
  PageTable& cell(const std::string& open, const std::string& content, bool is_number);

  std::string id_;
  std::vector<std::string> headings_;
  std::string rows_;
  std::set<std::size_t> numeric_columns_;
  std::size_t column_ = 0;
};

// Adds the cells of the tilts at which a series holds: the range, the best tilt, and the part within the
// wrist's range.
void add_holding(const SeriesSummary& summary, const StudyPlan& plan, PageTable& table);

}  // namespace spoonbill
