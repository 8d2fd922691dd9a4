#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "app/commands/option_set.h"
#include "app/commands/option_values.h"
#include "app/files/documents.h"
#include "app/report/csv_text.h"
#include "engine/base/file.h"
#include "engine/bspline/evaluate.h"

namespace spoonbill {
namespace {

constexpr Range<int> sample_grid_range{2, 4096};
constexpr std::size_t chunk_bytes = 1 << 20;

struct SampleOptions {
  std::filesystem::path model;
  Extent grid{50, 50};
  std::filesystem::path out;
  OutputOptions how;
};

// Passes the rows of a body to `write` in chunks, and stops at the first error of `write`.
template <class Write>
Status sample_body(const Body& body, Extent counts, Write write) {
  const Surface& surface = body.surface;
  const auto grid = make_grid(surface.u, surface.v, uniform_parameters(surface.u, counts.width),
                              uniform_parameters(surface.v, counts.height));
  if (!grid) return grid.error();
  GridSamples<double> samples;
  samples.resize(static_cast<std::size_t>(grid->rows()) * static_cast<std::size_t>(grid->columns()));
  GridEvaluator<double> evaluator(grid.value(), best_instruction_set());
  evaluator.points_and_normals(surface.net.x.data(), surface.net.y.data(), surface.net.z.data(), samples);

  const std::string row_start = csv_field(body.name) + ",0";
  std::string text;
  for (std::size_t i = 0, sample = 0; i < grid->u.parameters.size(); ++i) {
    for (std::size_t j = 0; j < grid->v.parameters.size(); ++j, ++sample) {
      text += row_start;
      for (const double number :
           {grid->u.parameters[i], grid->v.parameters[j], samples.x[sample], samples.y[sample],
            samples.z[sample], samples.nx[sample], samples.ny[sample], samples.nz[sample]}) {
        append_csv_number(text, number);
      }
      text += '\n';
    }
    if (text.size() >= chunk_bytes || i + 1 == grid->u.parameters.size()) {
      if (Status written = write(text); !written) return written;
      text.clear();
    }
  }
  return {};
}

template <class Write>
Status sample_all(const std::vector<Body>& bodies, Extent counts, Write write) {
  if (Status begun = write(std::string("body,surface,u,v,x_m,y_m,z_m,nx,ny,nz\n")); !begun) return begun;
  for (const Body& body : bodies) {
    if (Status sampled = sample_body(body, counts, write); !sampled) return sampled;
  }
  return {};
}

Status sample(const SampleOptions& options, Console& console) {
  if (Status checked = check_output(options.out, options.how); !checked) return checked;
  const auto document = read_document_file(options.model);
  if (!document) return document.error();
  const std::vector<Body>& bodies = document->scene.bodies;
  if (Status surfaces = check_surfaces(bodies, options.model); !surfaces) return surfaces;
  if (options.out == "-") {
    return sample_all(bodies, options.grid, [&](const std::string& text) -> Status {
      console.out << text;
      return {};
    });
  }
  if (Status checked = check_is_not_source(options.out, options.model, "--out"); !checked) return checked;
  auto file = OutputFile::create(options.out, options.how);
  if (!file) return file.error();
  InterruptWatch interrupt;
  const Status sampled = sample_all(bodies, options.grid, [&](const std::string& text) -> Status {
    if (!interrupt.requested()) return file->write(text);
    interrupt.answer();
    return stopped_before_writing(options.out);
  });
  return sampled ? file->commit() : sampled;
}

}  // namespace

CommandEntry add_sample(OptionSet root) {
  auto options = std::make_shared<SampleOptions>();
  const OptionSet parser =
      root.add_command("sample", "Write points and unit normals of a model's surfaces as CSV");
  parser.set_footer(
      "The grid covers the whole knot domain of each surface including both ends, so the seam of a periodic\n"
      "direction appears twice. Lengths are in metres. Numbers read back to the same bits.\n"
      "Example: spoonbill sample assets/models/spoon-handle.json --grid 50x50 --out points.csv");
  parser.add_option("MODEL", options->model, "Document (.json)").require();
  parser
      .add_parsed(
          "--grid",
          [options](const std::string& text) -> Status {
            const auto grid = parse_extent(text, sample_grid_range, "50x50");
            if (!grid) return grid.error();
            options->grid = grid.value();
            return {};
          },
          "Points along u and v, each from 2 to 4096; default: 50x50")
      .show_as("UxV");
  parser.add_option("--out", options->out, "CSV file to write, or - for standard output").require();
  add_force_option(parser, options->how);
  return {parser, [options](Console& console) { return sample(*options, console); }};
}

}  // namespace spoonbill
