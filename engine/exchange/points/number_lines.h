// Lines of numbers in a text, and numbers of any type in bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace spoonbill {

// Some spreadsheets begin a text of UTF-8 with a mark that says nothing.
std::string_view without_byte_order_mark(std::string_view text);

// The next line, without its end, taken off the front of the text.
std::string_view take_line(std::string_view& text);

// The next word between blanks, and any of the marks, taken off the front; empty at the end.
std::string_view take_word(std::string_view& text, std::string_view marks = {});

// "1.5", "-2e3", "nan", "inf"; nothing for a word that is no number.
std::optional<double> number_of(std::string_view word);
std::optional<std::uint64_t> count_of(std::string_view word);

// The types of numbers that PLY and PCD know.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };
std::size_t bytes_of(NumberType type);

// The number at the bytes, which must hold it.
double number_at(const char* bytes, NumberType type, bool swapped);

}  // namespace spoonbill
