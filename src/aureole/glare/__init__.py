"""glare"""
