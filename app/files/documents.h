// Reads documents and makes new ones. The error for a file of another format suggests a command. New
// documents are made around a surface, a stock shape, a CAD model or a fitted scan.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/base/result.h"
#include "engine/exchange/document.h"
#include "engine/scene/material.h"

namespace spoonbill {

struct CadModel;
struct ScanFit;

// Returns an error if the name is that of a CAD file, a mesh or a scan. The error names the command that
// converts the file.
Status check_native_name(const std::filesystem::path& file);

// Reads a document. For the name of a file of another format, returns the error of check_native_name().
Result<Document> read_document_file(const std::filesystem::path& file);

// Returns an error if a body has a mesh instead of a surface. The error names the file and the body.
Status check_surfaces(const std::vector<Body>& bodies, const std::filesystem::path& file);

// Returns a document with one fixed body, which a closed mesh bounds. Errors: those of check_mesh().
Result<Document> make_mesh_document(const std::string& name, CleanMesh mesh, const Material& material);

// Returns the names of the materials that come with the program, sorted.
std::vector<std::string> shipped_material_names();

// Reads a material that comes with the program, by its name or by a part that occurs in no other name, such
// as "clay" for modelling-clay. The error lists all names.
Result<Material> shipped_material(const std::string& name);

// Returns a document with one body around the surface, to be shaped by local strokes. A plane fixes a tenth
// of the body's height at its foot or, if the body is flat, a tenth of its length at the left end. The radius
// of the ball tool follows from the body's size, and the force scale makes the forces perceptible.
// `shell_thickness_m`: see Body.
Document starting_document(const std::string& name, Surface surface, const Material& material,
                           std::optional<double> shell_thickness_m = {});

// Halves the elements of the first body's surface that are longer than the tool's radius, exactly, so that
// the surface follows a stroke from the start. Stops before it has more control points than the program adds
// by itself.
Status suit_net_to_tool(Scene& scene);

// A size of a stock shape, such as the radius.
struct StockShapeField {
  const char* name;
  double default_mm;
};

// A stock shape of the window's New shape prompt.
struct StockShapeKind {
  const char* name;  // name of the kind, such as "Sphere"
  std::vector<StockShapeField> fields;
};

// Returns the stock shapes that a lattice can fill.
std::span<const StockShapeKind> stock_shape_kinds();

struct StockShapeChoice {
  std::size_t kind = 0;          // index into stock_shape_kinds()
  std::vector<double> sizes_mm;  // one size per field of the kind
};

StockShapeChoice default_stock_shape(std::size_t kind);

// Returns a document around the stock shape; a bowl is not pitched. The surface deviates from the exact shape
// by at most 0.1 mm. This tolerance needs few control points, so a tick can be computed in a millisecond. The
// error names a size that is out of range.
Result<Document> make_stock_shape_document(const StockShapeChoice& choice, const Material& material);

// Returns a document with one body of modelling clay per surface. All other settings are those that
// starting_document() chooses for the first surface. Returns an error for more surfaces than a document can
// have bodies.
Result<Document> make_cad_document(const CadModel& model, const std::string& name);

struct FittedDocument {
  Document document;
  // Notes on bodies that cannot be simulated, on bodies that get a box of cells, and on too many bodies.
  std::vector<std::string> notes;
};

// Returns a starting_document() of clay bodies for a fitted scan. Closed surfaces become solids. Other
// surfaces become shells. The thickness of a shell is a hundredth of its size, at most 2 mm, or less if no
// lattice can be made with it. Returns an error for more bodies than a document can have.
Result<FittedDocument> make_fitted_document(const ScanFit& fit, const std::string& name,
                                            const Material& clay);

}  // namespace spoonbill
