#include "app/study/page_parts.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/assets_folder.h"
#include "app/report/quantity_text.h"
#include "app/study/study_tables.h"
#include "engine/base/assert.h"
#include "engine/base/file.h"
#include "engine/base/text.h"

namespace spoonbill {

std::string html(std::string_view text) {
  std::string safe;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += letter;
    }
  }
  return safe;
}

std::string base64(std::string_view bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[at + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? digits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

const char* name_of(Verdict verdict) {
  return verdict_names[static_cast<std::size_t>(verdict)];
}

std::string degrees(double angle_deg) {
  return number_text(std::round(10.0 * angle_deg) / 10.0 + 0.0) + "°";
}

std::string range_text(const Range<double>& range_deg) {
  return degrees(range_deg.low) + " to " + degrees(range_deg.high);
}

std::string data_element(const char* id, const Json& data) {
  std::string json = data.dump();
  // A "<" in a name could end the script element.
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos;) json.replace(at, 1, "\\u003c");
  return std::string("<script type=\"application/json\" id=") + id + ">" + json + "</script>\n";
}

Result<std::string> make_page(const std::string& title, const std::string& heading, const std::string& body) {
  constexpr std::size_t part_limit_bytes = std::size_t{1} << 20;
  const std::filesystem::path folder = std::filesystem::path(assets_folder) / "report";
  const auto style = read_file(folder / "study.css", part_limit_bytes);
  if (!style) return style.error();
  const auto script = read_file(folder / "study.js", part_limit_bytes);
  if (!script) return script.error();
  return "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport "
         "content=\"width=device-width, initial-scale=1\"><title>" +
         html(title) + "</title>\n<style>\n" + style.value() + "</style></head><body>\n<h1>" + html(heading) +
         "</h1>\n" + body + "<script>\n" + script.value() + "</script>\n</body></html>\n";
}

PageTable::PageTable(std::string_view id, std::vector<std::string> headings)
    : id_(id), headings_(std::move(headings)) {}

PageTable& PageTable::row() {
  SPOONBILL_ASSERT(rows_.empty() || column_ == headings_.size());
  rows_ += rows_.empty() ? "<tr>" : "</tr><tr>";
  column_ = 0;
  return *this;
}

PageTable& PageTable::text(std::string_view value) {
  return cell("<td>", html(value), false);
}

PageTable& PageTable::long_text(std::string_view value) {
  return cell("<td class=long>", html(value), false);
}

PageTable& PageTable::number(double value, const std::string& shown) {
  return cell("<td class=number data-value=\"" + number_text(value) + "\">", html(shown), true);
}

PageTable& PageTable::number(double value, int decimals) {
  return number(value, decimals_text(value, decimals));
}

PageTable& PageTable::verdict(Verdict verdict) {
  const std::string name = name_of(verdict);
  return cell("<td>", "<span class=\"badge " + name + "\">" + name + "</span>", false);
}

std::string PageTable::finish() {
  SPOONBILL_ASSERT(rows_.empty() || column_ == headings_.size());
  std::string text = "<div class=scroll><table class=sortable id=" + id_ + "><thead><tr>";
  for (std::size_t k = 0; k < headings_.size(); ++k) {
    text += (numeric_columns_.contains(k) ? "<th class=number>" : "<th>") + html(headings_[k]) + "</th>";
  }
  return text + "</tr></thead><tbody>" + rows_ + (rows_.empty() ? "" : "</tr>") + "</tbody></table></div>\n";
}

PageTable& PageTable::cell(const std::string& open, const std::string& content, bool is_number) {
  rows_ += open + content + "</td>";
  if (is_number) numeric_columns_.insert(column_);
  ++column_;
  return *this;
}

std::string section(const char* id, const char* heading) {
  return std::string("<section id=") + id + "><h2>" + heading + "</h2>\n";
}

std::string series_label(const StudySeries& series) {
  return series.base.food + ", friction " + number_text(series.base.friction) +
         (variation_text(series.base).empty() ? "" : ", " + variation_text(series.base));
}

void add_holding(const SeriesSummary& summary, const StudyPlan& plan, PageTable& table) {
  if (!summary.holds_deg) {
    table.text("at no tilt tried").text("").text("");
    return;
  }
  const Range<double>& holds = *summary.holds_deg;
  const std::string range = degrees(holds.low) + (summary.is_open_low ? " or less" : "") + " to " +
                            degrees(holds.high) + (summary.is_open_high ? " or more" : "");
  table.number(holds.high - holds.low, range);
  const bool is_open = summary.is_open_low || summary.is_open_high;
  table.number(summary.best_deg, is_open
                                     ? "centre of what was tried, " + degrees(summary.best_deg)
                                     : degrees(summary.best_deg) + " ± " + degrees(summary.uncertainty_deg));
  const WristReading wrist = read_as_wrist(holds, plan);
  table.text(wrist.is_within ? range_text(wrist.common_deg) : "outside the range");
}

}  // namespace spoonbill
