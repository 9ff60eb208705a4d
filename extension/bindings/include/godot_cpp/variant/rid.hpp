#pragma once

#include <cstdint>

namespace godot {

/// The ID of a resource of an engine server.
class RID {
public:
	bool is_valid() const { return id_ != 0; }
	int64_t get_id() const { return static_cast<int64_t>(id_); }

	bool operator==(const RID &) const = default;

private:
	uint64_t id_ = 0;
};

} // namespace godot
