#pragma once

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// Iterates over a node and all its descendants, across several frames if necessary. May or may not
/// visit nodes that are added or removed during the iteration.
class TreeWalk {
public:
	/// Starts a new iteration at `p_root`.
	void start(godot::Node *p_root);
	void stop() { path_.clear(); }

	/// Returns the next node, or null after the last one.
	godot::Node *next();

private:
	struct Step {
		godot::Variant node;
		int32_t next_child = 0;
	};

	std::vector<Step> path_; ///< The path from the root to the last visited node.
};

} // namespace thicket
