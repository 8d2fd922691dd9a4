// A small document that is made in code, so that tests need no file: a closed tube with poles at both ends.
#pragma once

#include <filesystem>
#include <string>

#include "engine/exchange/document.h"

namespace spoonbill {

// Returns a document with 6 x 8 control points, 40 mm long, with lengths as a person would write them.
Document sample_document();

// Returns an open cubic sheet with so many control points, a millimetre apart.
Surface wavy_sheet(int rows, int columns);

// Returns the sample document with every length random, as in a deformed body.
Document deformed_document(unsigned seed);

// Compares the names, views, tools, fixing planes and sculpting settings of two documents, and the first body
// of each. Numbers must be equal to the last bit; -0 differs from 0.
bool same_bits(const Document& a, const Document& b);

// A temporary folder. The destructor removes it with all its contents.
class TemporaryFolder {
 public:
  TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

std::string content_of(const std::filesystem::path& file);

}  // namespace spoonbill
