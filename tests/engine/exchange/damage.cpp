#include "tests/engine/exchange/damage.h"

#include <cstdint>

namespace spoonbill {

std::string damaged(std::string text, std::size_t from, std::mt19937_64& random) {
  const std::string tempting("{}[]\",:0123456789-+.eE \n\\u\x00\xff", 28);
  for (std::uint64_t changes = 1 + random() % 4; changes > 0; --changes) {
    if (text.size() <= from) return text + "x";
    const std::size_t at = from + random() % (text.size() - from);
    switch (random() % 4) {
      case 0:
        text[at] = static_cast<char>(random());
        break;
      case 1:
        text[at] = tempting[random() % tempting.size()];
        break;
      case 2:
        text.erase(at, 1 + random() % 20);
        break;
      default:
        text.insert(at, std::string(text, random() % text.size(), random() % 40));
        break;
    }
  }
  return text;
}

}  // namespace spoonbill
