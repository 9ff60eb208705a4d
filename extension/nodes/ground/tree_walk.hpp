#pragma once

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// Visits a node and all below it, some at a time. What comes or goes meanwhile may be missed or met.
class TreeWalk {
public:
	/// Begins anew.
	void start(godot::Node *p_root);
	void stop() { path_.clear(); }

	/// The next node; null when all were visited.
	godot::Node *next();

private:
	struct Step {
		godot::Variant node;
		int32_t next_child = 0;
	};

	std::vector<Step> path_; ///< Down to the node that was visited last.
};

} // namespace thicket
