// Asks for the lump to begin anew with: its kind and sizes. One owner; the thread that draws.
#pragma once

#include <optional>
#include <string>

#include "app/files/documents.h"

namespace spoonbill {

class LumpPrompt {
 public:
  // Shows from the next draw() on, with what was chosen before.
  void ask();
  void close() { asking_ = false; }
  bool asking() const { return asking_; }
  // The choice makes no lump: asks again, saying why.
  void refuse(std::string problem);

  // Between begin_frame() and end_frame(). What was chosen, once.
  std::optional<LumpChoice> draw();

 private:
  void draw_fields();

  bool asking_ = false;
  bool appearing_ = false;
  LumpChoice choice_ = default_stock_shape(0);
  std::string problem_;
};

}  // namespace spoonbill
