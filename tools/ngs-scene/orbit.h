#pragma once
// ngs-scene orbit: a model without photos -> cameras, renders and scene.json.

namespace ngs::capture {

int orbit_command(int argc, char** argv);

}  // namespace ngs::capture
