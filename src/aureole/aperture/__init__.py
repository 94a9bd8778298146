"""aperture"""
