// A contact sheet: the frames of a recording side by side, read in one look.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "render/image/image.h"

namespace spoonbill {

struct ContactSheetLayout {
  int columns = 4;
  int cell_width_px = 480;  // the height follows from the first frame's proportions
  int margin_px = 12;
  int caption_px = 0;             // the size of the captions' letters; 0 leaves captions out
  std::string caption_font_path;  // a TrueType file, needed for captions
};

// Composes a sheet picture by picture, so that a long recording's frames need not be kept at full size.
class ContactSheet {
 public:
  explicit ContactSheet(ContactSheetLayout layout) : layout_(std::move(layout)) {}

  // Shrinks the frame (averaging in linear light) and keeps the small copy.
  void add(const Image& frame, std::string caption = {});

  std::size_t size() const { return cells_.size(); }

  // Refused: no frames, a caption font that cannot be read.
  Result<Image> compose() const;

 private:
  struct Cell {
    Image picture;
    std::string caption;
  };
  ContactSheetLayout layout_;
  std::vector<Cell> cells_;
};

// The picture at a smaller size, each pixel the mean in linear light of the area that it covers.
Image shrink(const Image& image, int width_px, int height_px);

}  // namespace spoonbill
