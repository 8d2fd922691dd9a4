// Contact sheets: the frames of a recording side by side on one picture.
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/result.h"
#include "render/image.h"

namespace spoonbill {

struct ContactSheetLayout {
  int columns = 4;
  int cell_width_px = 480;  // the height follows from the aspect ratio of the first frame
  int margin_px = 12;
  int caption_px = 0;             // height of a line of caption; 0 omits the captions
  std::string caption_font_path;  // a TrueType file, required for captions
};

// Composes a sheet frame by frame, so that the frames of a long recording need not be stored at full size.
class ContactSheet {
 public:
  explicit ContactSheet(ContactSheetLayout layout) : layout_(std::move(layout)) {}

  // Adds a small copy of the frame, averaged in linear light.
  void add(const Image& frame, std::string caption = {});

  std::size_t size() const { return cells_.size(); }

  // Returns the sheet. Errors: no frames, a caption font that cannot be read.
  Result<Image> compose() const;

 private:
  struct Cell {
    Image picture;
    std::string caption;
  };
  ContactSheetLayout layout_;
  std::vector<Cell> cells_;
};

// Returns the picture at a smaller size. Each pixel is the mean, in linear light, of the area that it covers.
Image shrink(const Image& image, int width_px, int height_px);

}  // namespace spoonbill
