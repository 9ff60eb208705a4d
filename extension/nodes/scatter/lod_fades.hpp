#pragma once

#include "core/placement/lod_span.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// How a mesh of a layer is drawn: the one near by, then those for the distance, one for each of its LODs.
std::vector<MeshLook> lods_of(const LayerDrawing &drawing, std::size_t mesh);

/// The LODs of one mesh of a layer, as they are and as they fade. LODs in a row that are drawn alike are one look.
class LodChain {
public:
	LodChain(const LayerDrawing &drawing, const LodSettings &lod, std::size_t mesh);

	/// Of each LOD. Nothing fades before all is made.
	std::span<const LodStep> steps() const { return steps_; }
	bool is_made() const { return made_ == looks_.size(); }

	/// Makes what is needed to fade one of its looks, taken over from another chain that has the same. Milliseconds for a large mesh, which is read
	/// back from the renderer.
	void make_next(const LodChain *before);

	/// True if a part of a tile is drawn by these LODs.
	bool is_of(std::span<const MeshLook> lods) const;

	/// How many looks are drawn in a span, less one.
	std::size_t looks_beyond_first(const LodSpan &span) const { return look_of_[span.last] - look_of_[span.first]; }

	/// One of the looks of a span, 0 for that of its first LOD.
	const MeshLook &look(const LodSpan &span, std::size_t index) const;

	/// A look that stands alone in place of a span, of one of its LODs.
	const MeshLook &only_look(const LodSpan &span, std::size_t lod) const;

private:
	static constexpr std::size_t variants = 6; ///< Comes or not, times LodEnd.
	struct Look {
		std::size_t first = 0; ///< LODs.
		std::size_t last = 0;
		MeshLook plain;
		std::array<MeshLook, variants> faded;
	};
	std::vector<FadeRange> ranges_of(const Look &look) const;

	LodSettings settings_;
	std::vector<std::uint64_t> surfaces_; ///< LayerDrawing::surfaces: others mean that meshes have changed.
	std::vector<LodStep> steps_;
	std::vector<LodStep> steps_when_made_;
	std::vector<std::size_t> look_of_; ///< Of each LOD.
	std::vector<Look> looks_;
	std::size_t made_ = 0;
};

/// The chains of all meshes of all layers. Main thread only.
class LodFades {
public:
	void set_layers(std::span<const SharedSnapshot> layers);

	/// Null for a mesh that is not drawn.
	const LodChain *find(std::uint32_t layer, std::size_t mesh) const;

	/// Makes some of what is still to be made; false if nothing is. `r_ready` is set where the last of a chain was made, which fades from now on.
	bool make_some(bool &r_ready);
	bool is_made() const { return layers_made_ == layers_.size(); }

private:
	struct Layer {
		SharedSnapshot of;
		std::vector<LodChain> chains;
		std::vector<LodChain> before; ///< What stood until the layer changed, to take over what is the same.
	};
	std::vector<Layer> layers_;
	std::size_t layers_made_ = 0;
};

} // namespace thicket
