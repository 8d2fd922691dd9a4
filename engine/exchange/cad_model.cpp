#include "engine/exchange/cad_model.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Length limit, in bytes, of names to which a number may be appended.
constexpr std::size_t shared_name_bytes_limit = cad_name_bytes_limit - 10;

// Returns the length of the UTF-8 character at `start` in bytes; 0 if no character starts there.
std::size_t character_bytes(const std::string& text, std::size_t start) {
  const auto byte = [&](std::size_t k) { return static_cast<unsigned char>(text[k]); };
  const unsigned first = byte(start);
  const std::size_t count = first < 0x80                     ? 1
                            : first >= 0xc2 && first <= 0xdf ? 2
                            : first >= 0xe0 && first <= 0xef ? 3
                            : first >= 0xf0 && first <= 0xf4 ? 4
                                                             : 0;
  if (count == 0 || start + count > text.size()) return 0;
  for (std::size_t k = start + 1; k < start + count; ++k) {
    if ((byte(k) & 0xc0) != 0x80) return 0;
  }
  // Overlong forms, surrogates and codes above U+10FFFF are not UTF-8.
  const unsigned second = count > 2 ? byte(start + 1) : 0x80;
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
    return 0;
  }
  return count;
}

// Returns true for U+0080 to U+009F, which terminals interpret as control codes.
bool is_control(std::string_view letter) {
  return letter.size() == 2 && letter[0] == '\xc2' && letter[1] < '\xa0';
}

}  // namespace

std::string clean_cad_name(const std::string& name, const std::string& fallback, std::size_t bytes_limit) {
  SPOONBILL_ASSERT(bytes_limit > 0);
  std::string clean;
  for (std::size_t k = 0; k < name.size();) {
    const std::size_t count = character_bytes(name, k);
    const bool is_printable =
        count > 1 ? !is_control(name.substr(k, count)) : count == 1 && name[k] >= ' ' && name[k] != '\x7f';
    if (clean.size() + std::max<std::size_t>(count, 1) > bytes_limit) break;
    clean += is_printable ? name.substr(k, count) : std::string(1, ' ');
    k += std::max<std::size_t>(count, 1);
  }
  const std::size_t first = clean.find_first_not_of(' ');
  if (first == std::string::npos) return fallback;
  return clean.substr(first, clean.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> make_names_unique(const std::vector<std::string>& names,
                                           const std::string& fallback) {
  std::vector<std::string> unique;
  std::map<std::string, int> uses;
  for (const std::string& name : names) {
    unique.push_back(clean_cad_name(name.substr(0, shared_name_bytes_limit), fallback));
    ++uses[unique.back()];
  }
  std::set<std::string> used;
  for (const auto& [name, times] : uses) used.insert(name);
  std::map<std::string, int> last_numbers;
  for (std::string& name : unique) {
    if (uses[name] == 1) continue;
    std::string numbered;
    do {
      numbered = name + " " + std::to_string(++last_numbers[name]);
    } while (used.contains(numbered));
    used.insert(numbered);
    name = numbered;
  }
  return unique;
}

}  // namespace spoonbill
