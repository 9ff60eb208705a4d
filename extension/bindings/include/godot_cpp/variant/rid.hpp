#pragma once

#include <cstdint>

namespace godot {

/// The identifier of a resource of one of the engine's servers.
class RID {
public:
	bool is_valid() const { return id_ != 0; }
	int64_t get_id() const { return static_cast<int64_t>(id_); }

	bool operator==(const RID &) const = default;

private:
	uint64_t id_ = 0;
};

} // namespace godot
