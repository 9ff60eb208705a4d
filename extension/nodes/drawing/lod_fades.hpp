#pragma once

#include "core/drawing/lod_runs.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Returns the MeshAppearance of each LOD of one mesh of a layer, finest first.
std::vector<MeshAppearance> lods_of(const LayerDrawing &drawing, std::size_t mesh);

/// The LODs of one mesh of a layer. Each has fading variants: copies of its mesh that appear or
/// disappear gradually over a range of distances. Consecutive LODs that are drawn identically share
/// one MeshAppearance (a run; see `LodRuns`).
class LodChain {
public:
	LodChain(const LayerDrawing &drawing, const LodSettings &lod, std::size_t mesh);

	/// Returns one step per LOD.
	std::span<const LodStep> steps() const { return runs_.steps(); }

	/// Returns true once all fading variants exist. Call `appearance` and `single_appearance` only
	/// then.
	bool is_complete() const { return completed_runs_ == meshes_.size(); }

	/// Creates the fading variants of the next run. Reuses those of the chain `previous` if it has
	/// the same run. Takes milliseconds for a large mesh, because the mesh is read back from the
	/// renderer.
	void make_next(const LodChain *previous);

	/// Returns true if this chain belongs to `lods`, the LODs of a part of a tile.
	bool matches(std::span<const MeshAppearance> lods) const;

	/// Returns how many runs a span of LODs has beyond the first one.
	std::size_t extra_run_count(const LodSpan &span) const { return runs_.extra_run_count(span); }

	/// Returns the appearance of one of the runs of a span. Index 0 is the run of its first LOD.
	const MeshAppearance &appearance(const LodSpan &span, std::size_t index) const;

	/// Returns the appearance of one LOD that is drawn alone, in place of the whole span.
	const MeshAppearance &single_appearance(const LodSpan &span, std::size_t lod) const;

private:
	struct Meshes {
		MeshAppearance plain;
		std::array<MeshAppearance, RunFade::count> fading_variants; ///< Indexed by RunFade::index.
	};
	const MeshAppearance &mesh_of(const LodRuns::DrawnRun &drawn_run) const;

	/// The value of LayerDrawing::surfaces for which the chain was created. If the current value
	/// differs, a mesh has changed.
	std::vector<std::uint64_t> surfaces_;
	LodRuns runs_;
	std::vector<Meshes> meshes_; ///< The meshes of each run.
	std::size_t completed_runs_ = 0;
};

/// The LOD chains of all meshes of all layers. Use it only on the main thread.
class LodFades {
public:
	void set_layers(std::span<const SharedSnapshot> layers);

	/// Returns the chain of a mesh of a layer; null for a mesh that is not drawn.
	const LodChain *find(std::uint32_t layer, std::size_t mesh) const;

	/// Creates some of the missing fading variants. Returns false if none is missing. Sets
	/// `r_chain_completed` to true if this completes a chain, because its LODs cross-fade from then
	/// on.
	bool make_some(bool &r_chain_completed);
	bool is_complete() const { return completed_layers_ == layers_.size(); }

private:
	struct Layer {
		SharedSnapshot snapshot;
		std::vector<LodChain> chains;
		/// The chains before the layer's last change. Their unchanged runs are reused.
		std::vector<LodChain> previous_chains;
	};
	std::vector<Layer> layers_;
	std::size_t completed_layers_ = 0;
};

} // namespace thicket
