#pragma once

#include "core/placement/layer_stage.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The stages of a layer and of all layers that it depends on, each of which stands once, before those that ask it. Keeps its
/// memory.
class StageChain {
public:
	explicit StageChain(const SampleMargins &margins) : sampler_(margins) {}

	/// Prepares for a layer of valid settings, which is copied.
	void set(const LayerSettings &layer);

	/// Samples all stages in the windows that the layer's own `rect` needs.
	Status sample(const Rect &rect, const std::atomic<bool> *cancel);

	/// Filters all stages; `ground` holds their places one stage after the other.
	Status filter(std::span<const Ground> ground, const std::atomic<bool> *cancel);

	std::size_t size() const { return size_; }
	const LayerStage &stage(std::size_t index) const { return *links_[index].stage; }

	/// That of the layer itself: the last.
	const LayerStage &own() const { return stage(size_ - 1); }

	const SampleStats &sample_stats() const { return sampler_.stats(); }

private:
	struct Link {
		const LayerSettings *layer = nullptr;
		std::unique_ptr<LayerStage> stage;
		double margin = 0.0;   ///< Meters around the rectangle of the layer itself in which it has to be known.
		double asked_to = 0.0; ///< The largest distance from which it is asked.
	};

	const LayerStage *add(const LayerSettings &layer);
	void find_margins();

	LayerSettings layer_;
	std::vector<Link> links_; ///< The first size_ are in use; the rest keep their memory.
	std::size_t size_ = 0;
	TileSampler sampler_;
};

} // namespace thicket
