#pragma once

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// Visits a node and all its descendants, some at a time. Nodes that are added or removed in the meantime may or may not be visited.
class TreeWalk {
public:
	/// Starts from the beginning.
	void start(godot::Node *p_root);
	void stop() { path_.clear(); }

	/// The next node; null when all were visited.
	godot::Node *next();

private:
	struct Step {
		godot::Variant node;
		int32_t next_child = 0;
	};

	std::vector<Step> path_; ///< The path down to the last visited node.
};

} // namespace thicket
