#pragma once
// Parts of the joint optimisation that --effect NAME=on|off switches. Each can be ablated alone.

namespace ngs {

struct JointSwitches {
  bool nerf = true, boundary = true, box = true, rbf = true, hash = true, fine_hash = true, film = true;
  bool align = true, variance = true, density = true, mask = true, cont = true, smooth = true;
  bool photometric = true, whole_photo = true, sh = true, antialias = true;
  bool geometry = true, mask_geometry = true;
};

}  // namespace ngs
