#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A viewer in the format of scatter_fade.gdshaderinc.
struct FadeViewer {
	std::uint64_t id = 0;  ///< The viewer's object ID in the engine.
	glm::vec4 place{0.0F}; ///< Its position in the engine's space, and its Viewer::radius_scale minus 1.
};

/// Passes viewers to the materials of a node's layers that include scatter_fade.gdshaderinc. Those materials measure fade distances from
/// these viewers, whichever camera draws. Nodes may share materials, so each material gets the viewers of all nodes. Main thread only.
class FadeViewers {
public:
	/// The largest number of viewers that the shader supports. If there are more, those nearest to the camera are used.
	static constexpr std::size_t most_viewers = 8;

	FadeViewers() = default;
	~FadeViewers() { clear(); }
	FadeViewers(const FadeViewers &) = delete;
	FadeViewers &operator=(const FadeViewers &) = delete;

	void set_layers(std::span<const SharedSnapshot> layers);

	/// Sets the node's viewers for this frame. If there are none, the previous viewers stay, and so do the tiles.
	/// `camera` is in the engine's space.
	void set_viewers(std::span<const FadeViewer> viewers, glm::vec3 camera);

	/// Removes the node's viewers and releases its materials. The materials then fade with the distance to the camera.
	void clear();

private:
	void write(std::span<const glm::vec4> viewers);

	std::vector<godot::Ref<godot::Material>> materials_;
	std::vector<FadeViewer> viewers_;
	std::uint64_t written_ = 0; ///< The version of all nodes' viewers last written to the materials; 0 if none was.
};

} // namespace thicket
