#pragma once

#include <cstdint>

namespace godot {

/// The name of something that a server of the engine holds.
class RID {
public:
	bool is_valid() const { return id_ != 0; }

private:
	uint64_t id_ = 0;
};

} // namespace godot
