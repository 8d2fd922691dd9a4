#include "engine/exchange/cad/iges_lines.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace spoonbill {
namespace {

constexpr std::size_t section_column = 72, field_length = 8;

// What a field of eight columns holds, if that is a whole number.
std::optional<long> number_in(const std::string& line, std::size_t start) {
  if (start >= line.size()) return {};
  std::string_view text = std::string_view(line).substr(start, field_length);
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string_view::npos) return {};
  text = text.substr(first, text.find_last_not_of(' ') + 1 - first);
  long number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

struct Lines {
  std::map<char, long> counts;  // of each section
  std::string last;             // the one that counts the others
  int null_entities = 0;
  long farthest = 0;                       // line of parameters that an entity asks for
  std::optional<long> parameters_of_next;  // from the first of an entity's two lines
};

void take_directory_line(const std::string& line, Lines& lines) {
  const bool is_first = ++lines.counts['D'] % 2 == 1;
  if (is_first) {
    if (number_in(line, 0) == 0) ++lines.null_entities;
    lines.parameters_of_next = number_in(line, field_length);
    return;
  }
  const auto count = number_in(line, 3 * field_length);
  if (!lines.parameters_of_next || !count) return;
  lines.farthest = std::max(lines.farthest, *lines.parameters_of_next + *count - 1);
}

Lines lines_of(const std::filesystem::path& file) {
  Lines lines;
  std::ifstream stream(file);
  for (std::string line; lines.last.empty() && std::getline(stream, line);) {
    if (line.size() <= section_column) continue;
    const char section = line[section_column];
    if (section == 'D') {
      take_directory_line(line, lines);
    } else if (section == 'T') {
      lines.last = line;
    } else {
      ++lines.counts[section];
    }
  }
  return lines;
}

Error damaged(const std::string& how) {
  return Error{"is cut short or damaged: " + how + "; copy it whole, or export it anew"};
}

}  // namespace

Result<int> count_null_entities(const std::filesystem::path& file) {
  Lines lines = lines_of(file);
  if (lines.counts['D'] == 0) return 0;
  if (lines.last.empty()) return damaged("its last line is missing");
  std::size_t start = 0;
  for (const char section : {'S', 'G', 'D', 'P'}) {
    const auto count = number_in(lines.last.substr(0, start + field_length), start + 1);
    if (lines.last[start] != section || !count) return damaged("its last line does not count the others");
    if (*count != lines.counts[section]) {
      return damaged("its last line counts " + std::to_string(*count) + " lines of section " + section +
                     ", and there are " + std::to_string(lines.counts[section]));
    }
    start += field_length;
  }
  if (lines.farthest > lines.counts['P']) {
    return damaged("the parameters of an entity would reach line " + std::to_string(lines.farthest) + " of " +
                   std::to_string(lines.counts['P']));
  }
  return lines.null_entities;
}

}  // namespace spoonbill
