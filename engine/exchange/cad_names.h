// Names of bodies that CAD files can hold and people can tell apart.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace spoonbill {

inline constexpr std::size_t longest_cad_name = 200;  // bytes

// UTF-8 of at most so many bytes without control characters, which other bytes than UTF-8 become; `instead`
// of what is empty then.
std::string clean_cad_name(const std::string& name, const std::string& instead,
                           std::size_t longest = longest_cad_name);

// Clean names in the same order, of which no two are equal: those that several share get a number, "wheel 1",
// "wheel 2". `instead` of what is empty.
std::vector<std::string> told_apart(const std::vector<std::string>& names, const std::string& instead);

}  // namespace spoonbill
