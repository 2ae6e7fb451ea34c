"""Many runs of plans, and what they say: how sure a plan works, what breaks it, which is better."""
