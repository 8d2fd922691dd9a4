#include "engine/exchange/cad/iges_globals.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fstream>
#include <string_view>

namespace spoonbill {
namespace {

constexpr std::size_t section_column = 72, most_lines = 2000, most_parameters = 26;
constexpr std::size_t model_scale = 12, unit_flag = 13, unit_name = 14;  // counted from 0

// The text of the lines that are marked as global.
std::string global_text(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string text, line;
  for (std::size_t k = 0; k < most_lines && std::getline(stream, line); ++k) {
    if (line.size() <= section_column || line[section_column] == 'S') continue;
    if (line[section_column] != 'G') break;
    text += line.substr(0, section_column);
  }
  return text;
}

// A string "3Habc" at `start`: how many letters it takes in all; 0 where there is none.
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

}  // namespace

std::vector<std::string> iges_global_parameters(const std::filesystem::path& file) {
  const std::string text = global_text(file);
  char between = ',', after = ';';
  std::vector<std::string> parameters;
  for (std::size_t k = 0; k < text.size() && parameters.size() < most_parameters;) {
    while (k < text.size() && text[k] == ' ') ++k;
    const std::size_t start = k;
    k += string_length(text, k);
    while (k < text.size() && text[k] != between && text[k] != after) ++k;
    parameters.push_back(without_spaces(text.substr(start, k - start)));
    // The first two name the separators themselves: "1H,".
    if (parameters.size() <= 2 && parameters.back().size() == 3) {
      (parameters.size() == 1 ? between : after) = parameters.back()[2];
    }
    if (k < text.size() && text[k] == after && parameters.size() > 2) break;
    ++k;
  }
  return parameters;
}

bool declares_iges_unit(const std::filesystem::path& file) {
  static constexpr std::array<std::string_view, 10> flags{"1", "2", "4", "5", "6", "7", "8", "9", "10", "11"};
  static constexpr std::array<std::string_view, 11> names{"2HIN", "4HINCH", "2HMM", "2HFT", "2HMI", "1HM",
                                                          "2HKM", "3HMIL",  "2HUM", "2HCM", "3HUIN"};
  static constexpr std::string_view as_named = "3";
  std::vector<std::string> parameters = iges_global_parameters(file);
  parameters.resize(std::max(parameters.size(), unit_name + 1));
  const std::string& flag = parameters[unit_flag];
  if (!flag.empty() && flag != as_named) return std::find(flags.begin(), flags.end(), flag) != flags.end();
  return std::find(names.begin(), names.end(), parameters[unit_name]) != names.end();
}

double iges_model_scale(const std::filesystem::path& file) {
  const std::vector<std::string> parameters = iges_global_parameters(file);
  if (parameters.size() <= model_scale) return 1.0;
  std::string text = parameters[model_scale];
  std::replace(text.begin(), text.end(), 'D', 'E');  // as Fortran has it
  double scale = 1.0;
  std::from_chars(text.data(), text.data() + text.size(), scale);
  return scale;
}

}  // namespace spoonbill
