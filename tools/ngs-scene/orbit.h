#pragma once
// ngs-scene orbit: a model without photos -> cameras chosen for it, renders in place of photos, and a scene.json of
// both.

namespace ngs::capture {

int orbit_command(int argc, char** argv);

}  // namespace ngs::capture
