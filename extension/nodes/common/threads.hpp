#pragma once

namespace thicket {

/// Whether the engine has threads to work on. Builds for the web may have none, and a project may forbid them.
bool has_threads();

} // namespace thicket
