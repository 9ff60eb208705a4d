#include "nodes/drawing/lod_fades.hpp"

#include "nodes/model/mesh_merge.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

bool same_appearance(const MeshAppearance &a, const MeshAppearance &b) {
	return a.same_meshes(b) && a.lod_appearance == b.lod_appearance;
}

/// Returns a mesh for each range: a copy that fades, or the original mesh if the range is `no_fade`
/// or no copy can be created.
std::vector<Ref<Mesh>> fading_copies(const Ref<Mesh> &mesh, std::span<const FadeRange> ranges) {
	std::vector<FadeRange> needed_ranges;
	std::ranges::copy_if(
			ranges, std::back_inserter(needed_ranges), [](const FadeRange &range) { return range != no_fade; });
	const std::vector<Ref<Mesh>> copies =
			mesh.is_valid() ? faded_meshes(mesh, needed_ranges) : std::vector<Ref<Mesh>>();
	std::vector<Ref<Mesh>> result;
	for (std::size_t next_copy = 0; const FadeRange &range : ranges) {
		const bool has_copy = range != no_fade && next_copy < copies.size() && copies[next_copy].is_valid();
		result.push_back(has_copy ? copies[next_copy] : mesh);
		next_copy += range != no_fade ? 1 : 0;
	}
	return result;
}

} // namespace

std::vector<MeshAppearance> lods_of(const LayerDrawing &drawing, std::size_t mesh) {
	std::vector<MeshAppearance> lods{drawing.meshes[mesh]};
	for (std::size_t index = mesh; index < drawing.lod_meshes.size(); index += drawing.meshes.size()) {
		const MeshAppearance &next = drawing.lod_meshes[index];
		lods.push_back(next.mesh.is_valid() ? next : lods.back());
	}
	return lods;
}

LodChain::LodChain(const LayerDrawing &drawing, const LodSettings &lod, std::size_t mesh) :
		surfaces_(drawing.surfaces) {
	if (!drawing.draws(mesh)) {
		return;
	}
	std::vector<LodStep> steps;
	for (const MeshAppearance &appearance : lods_of(drawing, mesh)) {
		const bool same_as_previous = !meshes_.empty() && same_appearance(appearance, meshes_.back().plain);
		steps.push_back({same_as_previous, appearance.fades});
		if (!same_as_previous) {
			meshes_.push_back({appearance, {}});
		}
	}
	runs_ = LodRuns(lod, steps);
	completed_runs_ = runs_.fades() ? 0 : meshes_.size();
}

void LodChain::make_next(const LodChain *previous) {
	auto &[plain, variants] = meshes_[completed_runs_];
	const std::array<FadeRange, RunFade::count> ranges = runs_.ranges(completed_runs_);
	const std::array<MeshAppearance, RunFade::count> *existing_variants = nullptr;
	if (previous != nullptr && previous->is_complete() && previous->surfaces_ == surfaces_) {
		for (std::size_t run = 0; existing_variants == nullptr && run < previous->meshes_.size(); ++run) {
			const Meshes &other = previous->meshes_[run];
			existing_variants = same_appearance(other.plain, plain) && previous->runs_.ranges(run) == ranges
					? &other.fading_variants
					: nullptr;
		}
	}
	if (existing_variants != nullptr) {
		// Reuse the existing copies, which fade over the same distances.
		variants = *existing_variants;
	} else if (plain.fades) {
		const std::vector<Ref<Mesh>> meshes = fading_copies(plain.mesh, ranges);
		const std::vector<Ref<Mesh>> shadows = fading_copies(plain.shadow.mesh, ranges);
		for (std::size_t variant = 0; variant < variants.size(); ++variant) {
			variants[variant] = {meshes[variant], {shadows[variant], plain.shadow.setting}, plain.lod_appearance, true};
		}
	} else {
		variants.fill(plain);
	}
	++completed_runs_;
}

bool LodChain::matches(std::span<const MeshAppearance> lods) const {
	if (lods.size() != runs_.steps().size()) {
		return false;
	}
	for (std::size_t lod = 0; lod < lods.size(); ++lod) {
		if (!same_appearance(lods[lod], meshes_[runs_.run_of(lod)].plain)) {
			return false;
		}
	}
	return true;
}

const MeshAppearance &LodChain::mesh_of(const LodRuns::DrawnRun &drawn_run) const {
	const Meshes &meshes = meshes_[drawn_run.run];
	return drawn_run.fade ? meshes.fading_variants[drawn_run.fade->index()] : meshes.plain;
}

const MeshAppearance &LodChain::appearance(const LodSpan &span, std::size_t index) const {
	return mesh_of(runs_.drawn_run(span, index));
}

const MeshAppearance &LodChain::single_appearance(const LodSpan &span, std::size_t lod) const {
	return mesh_of(runs_.single_run(span, lod));
}

void LodFades::set_layers(std::span<const SharedSnapshot> layers) {
	layers_.resize(layers.size());
	for (std::size_t index = 0; index < layers.size(); ++index) {
		Layer &layer = layers_[index];
		const SharedSnapshot &snapshot = layers[index];
		const bool is_unchanged = layer.snapshot != nullptr && snapshot != nullptr &&
				layer.snapshot->drawing == snapshot->drawing && layer.snapshot->lod == snapshot->lod;
		if (!is_unchanged) {
			layer.previous_chains = std::exchange(layer.chains, {});
			for (std::size_t mesh = 0; snapshot != nullptr && mesh < snapshot->drawing.meshes.size(); ++mesh) {
				layer.chains.emplace_back(snapshot->drawing, snapshot->lod, mesh);
			}
		}
		layer.snapshot = snapshot;
	}
	completed_layers_ = 0;
}

const LodChain *LodFades::find(std::uint32_t layer, std::size_t mesh) const {
	const bool is_drawn = layer < layers_.size() && mesh < layers_[layer].chains.size();
	return is_drawn ? &layers_[layer].chains[mesh] : nullptr;
}

bool LodFades::make_some(bool &r_chain_completed) {
	for (; completed_layers_ < layers_.size(); ++completed_layers_) {
		Layer &layer = layers_[completed_layers_];
		for (std::size_t mesh = 0; mesh < layer.chains.size(); ++mesh) {
			LodChain &chain = layer.chains[mesh];
			if (!chain.is_complete()) {
				chain.make_next(mesh < layer.previous_chains.size() ? &layer.previous_chains[mesh] : nullptr);
				r_chain_completed = chain.is_complete();
				return true;
			}
		}
		layer.previous_chains.clear();
	}
	return false;
}

} // namespace thicket
