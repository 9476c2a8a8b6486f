"""Campaigns: much work in small seeded chunks, kept in a store, from one core to a cluster."""
