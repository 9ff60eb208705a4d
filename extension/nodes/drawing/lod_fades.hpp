#pragma once

#include "core/drawing/lod_looks.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The looks of one mesh of a layer: the look of the finest LOD, then one for each further LOD.
std::vector<MeshLook> lods_of(const LayerDrawing &drawing, std::size_t mesh);

/// The LODs of one mesh of a layer, plain and fading. Consecutive LODs that are drawn alike share one look.
class LodChain {
public:
	LodChain(const LayerDrawing &drawing, const LodSettings &lod, std::size_t mesh);

	/// One for each LOD.
	std::span<const LodStep> steps() const { return looks_.steps(); }

	/// True once all fading variants are created. The methods below require that.
	bool is_made() const { return made_ == meshes_.size(); }

	/// Creates the fading variants of the next look. Copies them from the chain `before` if that has the same look.
	/// Takes milliseconds for a large mesh, because the mesh is read back from the renderer.
	void make_next(const LodChain *before);

	/// True if a part of a tile is drawn with these LODs.
	bool is_of(std::span<const MeshLook> lods) const;

	/// The number of looks that are drawn in a span, minus one.
	std::size_t looks_beyond_first(const LodSpan &span) const { return looks_.beyond_first(span); }

	/// One of the looks of a span; 0 is the look of its first LOD.
	const MeshLook &look(const LodSpan &span, std::size_t index) const;

	/// The look of one LOD of a span when it is drawn alone, in place of the whole span.
	const MeshLook &only_look(const LodSpan &span, std::size_t lod) const;

private:
	struct Meshes {
		MeshLook plain;
		std::array<MeshLook, LookFade::count> faded; ///< By LookFade::index.
	};
	const MeshLook &mesh_of(const LodLooks::Drawn &drawn) const;

	std::vector<std::uint64_t> surfaces_; ///< LayerDrawing::surfaces. A difference means that meshes have changed.
	LodLooks looks_;
	std::vector<Meshes> meshes_; ///< One for each look.
	std::size_t made_ = 0;
};

/// The chains of all meshes of all layers. Main thread only.
class LodFades {
public:
	void set_layers(std::span<const SharedSnapshot> layers);

	/// Null for a mesh that is not drawn.
	const LodChain *find(std::uint32_t layer, std::size_t mesh) const;

	/// Creates some of the missing variants. Returns false if none is missing. Sets `r_ready` when this completes a
	/// chain, because the chain fades from then on.
	bool make_some(bool &r_ready);
	bool is_made() const { return layers_made_ == layers_.size(); }

private:
	struct Layer {
		SharedSnapshot of;
		std::vector<LodChain> chains;
		std::vector<LodChain> before; ///< The chains from before the layer changed, to copy looks that are the same.
	};
	std::vector<Layer> layers_;
	std::size_t layers_made_ = 0;
};

} // namespace thicket
