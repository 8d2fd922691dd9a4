// Text on a picture without GL, for captions.
#pragma once

#include <string>

#include "engine/base/result.h"
#include "render/image/image.h"

namespace spoonbill {

class CaptionFont {
 public:
  // Refused: a file that is missing or no TrueType font.
  static Result<CaptionFont> load(const std::string& path);

  // Draws one line of Latin-1 text in dark ink; (x_px, y_px) is the top left corner of the line, size_px its
  // height. What lies outside the picture is clipped.
  void draw(Image& image, const std::string& text, int x_px, int y_px, int size_px) const;

 private:
  std::string file_;  // its bytes
};

}  // namespace spoonbill
