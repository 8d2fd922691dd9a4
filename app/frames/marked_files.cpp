#include "app/frames/marked_files.h"

#include <utility>

#include "render/image.h"

namespace spoonbill {

Result<std::vector<std::string>> take_marks(Session& session,
                                            const std::optional<std::filesystem::path>& folder) {
  const std::vector<FileMark> marks = std::exchange(session.marks, {});
  std::vector<std::string> pictures;
  if (!folder) return pictures;
  for (const FileMark& mark : marks) {
    if (!mark.document) {
      pictures.push_back(mark.mark.name);
      continue;
    }
    const std::filesystem::path file = *folder / ("saved-" + mark.mark.name + ".json");
    if (Status written = write_document(*mark.document, file); !written) return written.error();
  }
  return pictures;
}

Status write_marked_picture(const Image& picture, const std::string& name,
                            const std::filesystem::path& folder) {
  return write_png(folder / ("picture-" + name + ".png"), picture);
}

}  // namespace spoonbill
