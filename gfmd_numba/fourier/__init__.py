"""The periodic grid, the transform convention, planned transforms and resampling."""
