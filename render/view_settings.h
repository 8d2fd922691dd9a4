// How a snapshot is shown: plain data, set by the panel, by a recording and by tests. Nothing here changes
// the simulation.
#pragma once

#include <memory>

#include "engine/base/geometry.h"
#include "engine/collision/stages/contact_stages.h"
#include "render/camera.h"

namespace spoonbill {

// The stages in which a contact is found, in their order (section 4.1 of Pungotra et al. 2013).
enum class ContactStage { none, hulls, spheres, triangles, contacts };

// What is drawn over the bare scene; each has one meaning and can be switched off.
struct Overlays {
  bool fixed_nodes = true;       // green squares
  bool touched_nodes = true;     // red discs
  bool lattice = false;          // the thinnest lines
  bool cells = false;            // thick lines: where the lattice's hexahedra meet the surface
  bool control_net = false;      // thin lines with points
  bool force = true;             // the force on the hand: an arrow with its newtons
  bool contact_normals = false;  // short lines out of the contact points
  bool fixing_planes = true;
  bool symmetry_plane = true;  // dash-dotted
  bool tool = true;
  bool ground_grid = true;
  bool scale_bar = true;
  bool legend = true;  // names what is on
  ContactStage contact_stage = ContactStage::none;
  int sphere_level = 0;  // of the spheres: 0, the coarsest, to finest_stage_level
};

struct ViewSettings {
  Camera camera;
  Rectangle panel_px;            // covered by the panel at the left or right edge; empty without one
  double interface_scale = 1.0;  // widths of lines and sizes of marks: 1 at 720 pixels of height

  Overlays overlays;
  std::shared_ptr<const ContactStages> stages;  // the snapshot's, for the contact stage; null draws none
  bool see_through_body = false;                // draws the body as a ghost, so that nodes inside it show

  Vector3 toward_key_light = Vector3(-0.42, 0.80, 0.43);  // any length; kept above the horizon when drawn
  bool shadow = true;
  int samples = 4;  // 0 or 4 samples a pixel
  double detail =
      1.0;  // of the tessellation: at 0.5 its edges are twice as long, its chords twice as far off
  bool keep_level = true;   // the tessellation may stay a little too fine or coarse, rather than flicker
  double ground_y_m = 0.0;  // see ground_below()
  double arrow_m_per_n = 0.012;
};

// The interface scale that keeps sizes legible: 1 up to 720 pixels of height, 2 at 1440.
double interface_scale_for(int height_px);

// The ground's height just below a model: its lowest point, less a gap that keeps it from touching.
double ground_below(const Box& model);

}  // namespace spoonbill
