// A small document made in code: a closed tube with poles at both ends, so that tests need no file.
#pragma once

#include <filesystem>
#include <string>

#include "engine/exchange/document.h"

namespace spoonbill {

// 6 x 8 control points, 40 mm long, lengths as a person would write them.
Document sample_document();

// The same with every length a random double, as a deformed body has them.
Document deformed_document(unsigned seed);

// Every bit of the scene, -0 and 0 told apart.
bool same_bits(const Document& a, const Document& b);

// A folder of its own, removed with everything in it.
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
