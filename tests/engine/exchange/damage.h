// Damages the bytes of a file in the same ways as careless editing or a failing disk.
#pragma once

#include <cstddef>
#include <random>
#include <string>

namespace spoonbill {

// Changes, removes or repeats one to four stretches of the text from byte `from` on. The result is never
// empty.
std::string damaged(std::string text, std::size_t from, std::mt19937_64& random);

}  // namespace spoonbill
