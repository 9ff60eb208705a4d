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

/// A viewer as scatter_fade.gdshaderinc takes it.
struct FadeViewer {
	std::uint64_t id = 0;  ///< Of the object of the engine that it is.
	glm::vec4 place{0.0F}; ///< Where it is in the engine's space, and its Viewer::radius_scale less 1.
};

/// Hands viewers to the materials of a node's layers that include scatter_fade.gdshaderinc: what fades measures from them, whichever
/// camera draws. Nodes may share materials, so each material gets the viewers of all nodes. Main thread only.
class FadeViewers {
public:
	/// As many viewers as the shader takes. Of more, those nearest to the camera count.
	static constexpr std::size_t most_viewers = 8;

	FadeViewers() = default;
	~FadeViewers() { clear(); }
	FadeViewers(const FadeViewers &) = delete;
	FadeViewers &operator=(const FadeViewers &) = delete;

	void set_layers(std::span<const SharedSnapshot> layers);

	/// The node's viewers in this frame. With none, the last ones stay, as tiles do. `camera` is in the engine's space.
	void set_viewers(std::span<const FadeViewer> viewers, glm::vec3 camera);

	/// Gives up the viewers and the materials, which fade with the distance to the camera from now on.
	void clear();

private:
	void write(std::span<const glm::vec4> viewers);

	std::vector<godot::Ref<godot::Material>> materials_;
	std::vector<FadeViewer> viewers_;
	std::uint64_t written_ = 0; ///< The version of all nodes' viewers that the materials have; 0 for none.
};

} // namespace thicket
