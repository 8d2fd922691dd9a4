// A small document made in code, so that tests need no file: a closed tube with poles at both ends.
#pragma once

#include <filesystem>
#include <string>

#include "engine/exchange/document.h"

namespace spoonbill {

// 6 x 8 control points, 40 mm long, lengths as a person would write them.
Document sample_document();

// Returns the same document with every length a random double, as in a deformed body.
Document deformed_document(unsigned seed);

// Compares every bit of the scene, and distinguishes -0 from 0.
bool same_bits(const Document& a, const Document& b);

// A temporary folder, removed with all its contents.
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
