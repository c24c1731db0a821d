"""Linear elastic bodies, condensed to the stiffness of their surface."""
