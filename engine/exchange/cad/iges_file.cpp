#include "engine/exchange/cad/iges_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fstream>
#include <map>
#include <optional>
#include <string_view>

namespace spoonbill {
namespace {

constexpr std::size_t section_column = 72, line_limit = 2000, iges_parameter_limit = 26;
constexpr std::size_t model_scale = 12, unit_flag = 13, unit_parameter = 14;  // indices of global parameters

// Returns the text of all lines of the global section.
std::string global_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text, line;
  for (std::size_t k = 0; k < line_limit && std::getline(stream, line); ++k) {
    if (line.size() <= section_column || line[section_column] == 'S') continue;
    if (line[section_column] != 'G') break;
    text += line.substr(0, section_column);
  }
  return text;
}

// Returns the length of a string such as "3Habc" at `start`; 0 if no string starts there.
std::size_t string_length(const std::string& text, std::size_t start) {
  std::size_t end = start;
  std::size_t count = 0;
  while (end < text.size() && end < start + 6 && std::isdigit(static_cast<unsigned char>(text[end])) != 0) {
    count = 10 * count + static_cast<std::size_t>(text[end++] - '0');
  }
  if (end == start || end >= text.size() || text[end] != 'H') return 0;
  return std::min(end + 1 + count, text.size()) - start;
}

std::string without_spaces(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), ' '), text.end());
  return text;
}

constexpr std::size_t field_length = 8;

// Returns the whole number in the field of eight columns that begins at `start`.
std::optional<long> parse_field(const std::string& line, std::size_t start) {
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

struct LineCounts {
  std::map<char, long> counts;  // number of lines of each section
  std::string last;             // last line of the file, which states the number of lines of each section
  int null_entities = 0;
  long farthest = 0;  // line number of the last parameter line that an entity refers to
  // Line number of the present entity's first parameter line. The first of the entity's two directory lines
  // states it.
  std::optional<long> parameters_of_next;
};

void add_directory_line(const std::string& line, LineCounts& lines) {
  const bool is_first = ++lines.counts['D'] % 2 == 1;
  if (is_first) {
    if (parse_field(line, 0) == 0) ++lines.null_entities;
    lines.parameters_of_next = parse_field(line, field_length);
    return;
  }
  const auto count = parse_field(line, 3 * field_length);
  if (!lines.parameters_of_next || !count) return;
  lines.farthest = std::max(lines.farthest, *lines.parameters_of_next + *count - 1);
}

LineCounts count_lines(const std::filesystem::path& file) {
  LineCounts lines;
  std::ifstream stream(file);
  for (std::string line; lines.last.empty() && std::getline(stream, line);) {
    if (line.size() <= section_column) continue;
    const char section = line[section_column];
    if (section == 'D') {
      add_directory_line(line, lines);
    } else if (section == 'T') {
      lines.last = line;
    } else {
      ++lines.counts[section];
    }
  }
  return lines;
}

Error damaged(const std::string& fault) {
  return Error{ErrorCode::malformed,
               "is cut short or damaged: " + fault + "; copy it whole, or export it again"};
}

}  // namespace

std::vector<std::string> read_iges_global_parameters(const std::filesystem::path& file) {
  const std::string text = global_text(file);
  char separator = ',', terminator = ';';
  std::vector<std::string> parameters;
  for (std::size_t k = 0; k < text.size() && parameters.size() < iges_parameter_limit;) {
    while (k < text.size() && text[k] == ' ') ++k;
    const std::size_t start = k;
    k += string_length(text, k);
    while (k < text.size() && text[k] != separator && text[k] != terminator) ++k;
    parameters.push_back(without_spaces(text.substr(start, k - start)));
    // The first two parameters are the separator and the terminator themselves: "1H,".
    if (parameters.size() <= 2 && parameters.back().size() == 3) {
      (parameters.size() == 1 ? separator : terminator) = parameters.back()[2];
    }
    if (k < text.size() && text[k] == terminator && parameters.size() > 2) break;
    ++k;
  }
  return parameters;
}

bool declares_iges_unit(const std::filesystem::path& file) {
  static constexpr std::array<std::string_view, 10> flags{"1", "2", "4", "5", "6", "7", "8", "9", "10", "11"};
  static constexpr std::array<std::string_view, 11> names{"2HIN", "4HINCH", "2HMM", "2HFT", "2HMI", "1HM",
                                                          "2HKM", "3HMIL",  "2HUM", "2HCM", "3HUIN"};
  static constexpr std::string_view as_named = "3";
  std::vector<std::string> parameters = read_iges_global_parameters(file);
  parameters.resize(std::max(parameters.size(), unit_parameter + 1));
  const std::string& flag = parameters[unit_flag];
  if (!flag.empty() && flag != as_named) return std::find(flags.begin(), flags.end(), flag) != flags.end();
  return std::find(names.begin(), names.end(), parameters[unit_parameter]) != names.end();
}

double iges_model_scale(const std::filesystem::path& file) {
  const std::vector<std::string> parameters = read_iges_global_parameters(file);
  if (parameters.size() <= model_scale) return 1.0;
  std::string text = parameters[model_scale];
  std::replace(text.begin(), text.end(), 'D', 'E');  // 'D' marks the exponent in Fortran
  double scale = 1.0;
  std::from_chars(text.data(), text.data() + text.size(), scale);
  return scale;
}

Result<int> count_null_entities(const std::filesystem::path& file) {
  LineCounts lines = count_lines(file);
  if (lines.counts['D'] == 0) return 0;
  if (lines.last.empty()) return damaged("its last line is missing");
  std::size_t start = 0;
  for (const char section : {'S', 'G', 'D', 'P'}) {
    const auto count = parse_field(lines.last.substr(0, start + field_length), start + 1);
    if (lines.last[start] != section || !count)
      return damaged("its last line does not state the number of lines of each section");
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
