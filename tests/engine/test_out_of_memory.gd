extends "harness.gd"
## To be run with little memory (see test_engine.py): what asks for too much prints an error, and all goes on.


func test_a_window_too_large_is_refused_and_a_small_one_comes() -> void:
	var sampler := PoissonSampler.new()
	var small := Rect2(0, 0, 30, 30)
	var expected: PackedVector2Array = sampler.sample(small)["positions"]
	var huge: PackedVector2Array = sampler.sample(Rect2(0, 0, 11000, 11000))["positions"]
	check(huge.is_empty(), "nothing comes of what does not fit")
	expect_memory_error("PoissonSampler.rect")
	check(sampler.sample(small)["positions"] == expected, "the sampler is as good as new")


func test_a_domain_too_large_is_refused_and_a_small_one_comes() -> void:
	for method: int in [PoissonSampler.METHOD_TILES, PoissonSampler.METHOD_HIERARCHICAL]:
		var sampler := PoissonSampler.new()
		sampler.method = method
		sampler.double_precision = true
		var small := Rect2(0, 0, 30, 30)
		var expected := sampler.sample_domain(small)
		check(sampler.sample_domain(Rect2(0, 0, 11000, 11000)).is_empty(), "nothing comes of what does not fit")
		expect_memory_error("PoissonSampler.rect")
		check(sampler.sample_domain(small) == expected, "the sampler is as good as new")


## One error of ours; the engine has one of its own wherever it has not enough memory for an array.
func expect_memory_error(asked_for: String) -> void:
	var told: Array = Array(errors.take()).filter(func(message: String) -> bool: return not 'Parameter "mem' in message)
	check(told.size() == 1, "one error, got %s" % [told])
	for message in told:
		check(message.begins_with(asked_for) and "more memory than is available" in message, message)
