// Reading of words and numbers from text, and of numbers of any type from bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace spoonbill {

// Returns the text without the byte order mark that some spreadsheets write at its beginning.
std::string_view without_byte_order_mark(std::string_view text);

// Removes the next line from the front of the text and returns it, without its line end.
std::string_view extract_line(std::string_view& text);

// Removes the next word from the front of the text and returns it; empty at the end. Words are separated by
// blanks and any of the separators.
std::string_view extract_word(std::string_view& text, std::string_view separators = {});

// Parses a number, such as "1.5", "-2e3", "nan" or "inf"; nullopt for any other word.
std::optional<double> parse_number(std::string_view word);
std::optional<std::uint64_t> parse_count(std::string_view word);

// Types of numbers in PLY and PCD files.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
std::size_t byte_count(NumberType type);

// Returns the number that starts at `bytes`, where byte_count(type) bytes must be readable. `swapped`
// reverses the byte order.
double number_at(const char* bytes, NumberType type, bool swapped);

}  // namespace spoonbill
