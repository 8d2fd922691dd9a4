#include "engine/exchange/ply_check.h"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace spoonbill {
namespace {

struct Element {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<bool> is_list;  // of each property
};

struct Header {
  bool is_text = false;
  std::vector<Element> elements;
};

// Up to its last line, past which the stream is left.
Result<Header> read_header(std::istream& stream) {
  Header header;
  std::size_t bytes = 0;
  for (std::string line; std::getline(stream, line) && bytes <= ply_header_bytes_limit;) {
    bytes += line.size() + 1;
    std::istringstream words(line);
    std::string keyword, name;
    words >> keyword >> name;
    if (keyword == "end_header") return header;
    if (keyword == "format") header.is_text = name == "ascii";
    if (keyword == "element") {
      header.elements.push_back({name, 0, {}});
      words >> header.elements.back().rows;
    }
    if (keyword == "property" && !header.elements.empty()) {
      header.elements.back().is_list.push_back(name == "list");
    }
  }
  return Error{"its header has no end within 64 KiB; it is cut or no PLY file"};
}

bool skip(std::istream& stream, std::uint64_t numbers) {
  std::string word;
  while (numbers > 0 && stream >> word) --numbers;
  return numbers == 0;
}

// A list is how many numbers it has, then these.
bool skip_list(std::istream& stream) {
  std::string word;
  if (!(stream >> word)) return false;
  const double count = std::strtod(word.c_str(), nullptr);
  return count >= 0.0 && count < 1e9 && skip(stream, static_cast<std::uint64_t>(count));
}

Status check_rows(std::istream& stream, const Element& element) {
  // Rows of nothing take no bytes, however many are promised.
  if (element.is_list.empty()) return {};
  for (std::uint64_t row = 0; row < element.rows; ++row) {
    for (const bool is_list : element.is_list) {
      if (is_list ? skip_list(stream) : skip(stream, 1)) continue;
      return Error{"it ends within " + element.name + " " + std::to_string(row + 1) + " of " +
                   std::to_string(element.rows) + "; it is cut or damaged"};
    }
  }
  return {};
}

}  // namespace

Status check_ply(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const Result<Header> header = read_header(stream);
  if (!header.ok()) return header.error();
  if (!header->is_text) return {};
  for (const Element& element : header->elements) {
    if (Status status = check_rows(stream, element); !status.ok()) return status;
  }
  return {};
}

}  // namespace spoonbill
