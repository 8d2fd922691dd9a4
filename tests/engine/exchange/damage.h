// What careless hands and failing disks do to the bytes of a file.
#pragma once

#include <cstddef>
#include <random>
#include <string>

namespace spoonbill {

// Changes, removes or repeats one to four stretches of the text from byte `from` on; never empties it.
std::string damaged(std::string text, std::size_t from, std::mt19937_64& random);

// How many random cases a test runs: `full` where SPOONBILL_FULL is set in the environment.
int random_cases(int quick, int full);

}  // namespace spoonbill
