#include "engine/exchange/cad_names.h"

#include <algorithm>
#include <map>
#include <set>
#include <string_view>

#include "engine/base/assert.h"

namespace spoonbill {
namespace {

// Bytes that leave room for a number.
constexpr std::size_t longest_shared_name = longest_cad_name - 10;

// How many bytes of UTF-8 begin at `start`; 0 where none do.
std::size_t letter_bytes(const std::string& text, std::size_t start) {
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
  // Overlong forms, surrogates, beyond Unicode.
  const unsigned second = count > 2 ? byte(start + 1) : 0x80;
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
    return 0;
  }
  return count;
}

// U+0080 to U+009F, which terminals obey.
bool is_control(std::string_view letter) {
  return letter.size() == 2 && letter[0] == '\xc2' && letter[1] < '\xa0';
}

}  // namespace

std::string clean_cad_name(const std::string& name, const std::string& instead, std::size_t longest) {
  SPOONBILL_ASSERT(longest > 0);
  std::string clean;
  for (std::size_t k = 0; k < name.size();) {
    const std::size_t count = letter_bytes(name, k);
    const bool shown =
        count > 1 ? !is_control(name.substr(k, count)) : count == 1 && name[k] >= ' ' && name[k] != '\x7f';
    if (clean.size() + std::max<std::size_t>(count, 1) > longest) break;
    clean += shown ? name.substr(k, count) : std::string(1, ' ');
    k += std::max<std::size_t>(count, 1);
  }
  const std::size_t first = clean.find_first_not_of(' ');
  if (first == std::string::npos) return instead;
  return clean.substr(first, clean.find_last_not_of(' ') - first + 1);
}

std::vector<std::string> told_apart(const std::vector<std::string>& names, const std::string& instead) {
  std::vector<std::string> apart;
  std::map<std::string, int> uses;
  for (const std::string& name : names) {
    apart.push_back(clean_cad_name(name.substr(0, longest_shared_name), instead));
    ++uses[apart.back()];
  }
  std::set<std::string> taken;
  for (const auto& [name, times] : uses) taken.insert(name);
  std::map<std::string, int> given;
  for (std::string& name : apart) {
    if (uses[name] == 1) continue;
    std::string numbered;
    do {
      numbered = name + " " + std::to_string(++given[name]);
    } while (taken.contains(numbered));
    taken.insert(numbered);
    name = numbered;
  }
  return apart;
}

}  // namespace spoonbill
