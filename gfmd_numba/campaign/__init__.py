"""Campaigns: from a YAML file to cases, a plan, and a run."""
